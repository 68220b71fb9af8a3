mod crossing;
mod hits;
