"""Files and caches on disk.

files          files that are whole or absent
tables         types of what TOML and JSON files hold
user_files     refusal of files without end or beyond the memory
number_table   tables of numbers from CSV files
array_cache    arrays that are expensive to make
cache_folder   folder of the compiled kernels;  kernel_files: their digests
"""
