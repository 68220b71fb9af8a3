"""Adapters for simulators: each keeps one cloth apart, step by step."""
