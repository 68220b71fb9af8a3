mod behind;
mod crossing;
mod distances;
mod hits;
mod hubs;
mod inside;
mod polygons;
