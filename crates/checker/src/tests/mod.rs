mod crossing;
mod hits;
mod hubs;
mod inside;
mod polygons;
