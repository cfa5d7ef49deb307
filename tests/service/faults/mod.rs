//! Databases, descriptors and logs that fail for a while, and processes that are killed.

mod failed_commits;
mod outages;
mod replaced;
mod storage;
mod unmounted;
mod unreadable;
