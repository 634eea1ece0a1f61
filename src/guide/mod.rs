//! Source tree -> builder: what it does, the words, the reasons, and where to add what. No code, only texts.

#[doc = include_str!("features.md")]
pub mod features {}

#[doc = include_str!("words.md")]
pub mod words {}

#[doc = include_str!("reasons.md")]
pub mod reasons {}

#[doc = include_str!("extending.md")]
pub mod extending {}
