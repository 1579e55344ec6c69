"""Text documents: written all or none, and JSON read and checked against its schema."""
