//! The page over HTTP: who may ask (`guard`), what is at which address (`routes`), connections (`server`).

mod guard;
mod routes;
mod server;

pub(super) use server::Server;
