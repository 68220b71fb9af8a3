//! A small cloth simulator that talks to untangled.
