//! ztest
