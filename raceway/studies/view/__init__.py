"""Pictures of a bearing."""
