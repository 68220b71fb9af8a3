//! From a point inside to its target: charts and radial basis functions.
