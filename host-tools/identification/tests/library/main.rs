//! The library from outside, by what is public of it.

mod calibration;
mod character;
mod cost;
mod feedforward;
mod fit;
mod genetic_algorithm;
mod least_squares;
mod search;
mod space;
