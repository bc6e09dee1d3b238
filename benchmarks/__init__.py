"""Measurements that the documents quote; run from the root of the repository."""
