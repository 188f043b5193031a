//! Identification, control and safety of the display board as pure steps.
#![cfg_attr(not(test), no_std)]
