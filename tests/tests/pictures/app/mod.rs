//! The app's logic: its table of steps, every order of events, and a person's way to a moving toy.

mod conditions;
mod failures;
mod happenings;
mod heat;
mod lens;
mod orders;
mod phone_check;
mod phones;
mod planes;
mod recorded;
mod screens;
mod search;
mod starts;
mod table;
mod times;
mod toys;
mod way;
mod world;
