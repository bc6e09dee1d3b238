"""The rigid model in full depth, one subject a file."""
