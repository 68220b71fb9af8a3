mod crossing;
mod hits;
mod hubs;
