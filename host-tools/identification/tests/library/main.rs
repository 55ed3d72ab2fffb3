//! The library from outside, by what is public of it.

mod adversary;
mod baseline;
mod character;
mod cost;
mod fit;
mod genetic_algorithm;
mod preisach;
mod reversals;
mod search;
mod space;
