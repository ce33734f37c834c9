//! The figures that benches wrote, read again: what they hold, whether they still describe the
//! program, and the tables of papers that a page makes of them.
//!
//! | file | what it does |
//! |---|---|
//! | [`member`] | members of JSON that anyone may have written, with errors that name them |
//! | [`files`] | the files of a folder of results: what each is about, and who measured it |
//! | [`short_run`] | what of a file is measured again, in little time |
//! | [`cells`] | the figures of a file that can be compared, in one form |
//! | [`compare`] | committed figures and today's side by side, and the verdict |
//! | [`tables`] | the tables of a file beside its paper's |
//! | `mbvh_page`, `coherent_page`, `kd_page`, `render_page` | those of each bench |
//! | [`page`] | tables put between the marks of a page |

pub mod cells;
mod coherent_page;
pub mod compare;
pub mod files;
mod kd_page;
mod mbvh_page;
pub mod member;
pub mod page;
mod render_page;
pub mod short_run;
pub mod tables;
#[cfg(test)]
mod tests;
