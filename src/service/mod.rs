//! The daemon: sessions, ingest, publish, housekeeping. The only user of iceoryx2 in this package.
