//! The library from outside, by what is public of it.

mod adversary;
mod doubt;
mod fit;
mod genetic_algorithm;
mod lagged;
mod learnt;
mod preisach;
mod rest;
mod search;
mod space;
