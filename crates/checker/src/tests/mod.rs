mod crossing;
mod distances;
mod hits;
mod hubs;
mod polygons;
