//! Commands of `palpate` as a person calls them. One program: linking it takes longer than most of its tests.

mod board;
mod feel;
mod identify;
mod init;
mod model;
mod printing;
mod results;
mod simulate;
mod studies;
mod sweep;
mod tour;
mod track;
mod trial;
