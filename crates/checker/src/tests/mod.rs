mod crossing;
mod hits;
mod hubs;
mod polygons;
