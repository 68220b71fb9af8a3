//! What a host links to talk to the untangled daemon.
