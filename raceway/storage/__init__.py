"""Files and caches on disk.

files          files that are whole or absent; refusal of files without end or beyond the memory
tables         types of what TOML and JSON files hold
number_table   tables of numbers from CSV files;  headings: column headers and clocks below preambles of instruments
array_cache    arrays that are expensive to make
kernel_cache   folder of the compiled kernels and their digests
"""
