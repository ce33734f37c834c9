//! Ray sets to measure and compare structures with, and the measuring.
//!
//! | file | what it does |
//! |---|---|
//! | [`ray_sets`] | rays over a scene: random, primary, bounce and hostile ones |
//! | [`measure`] | answers compared, passes timed by turns, work counted |
//! | [`kd`] | kd-trees side by side: Hapala and Havran's table 3 |
//! | [`kd_growth`] | how their builds grow with the scene |
//! | [`mbvh`] | multi bounding volume hierarchies: Ernst and Greiner's tables and figure 4 |
//! | [`fly_through`] | many rays at once over flights: Barczak's tables |
//! | [`renders`] | whole renders: their figure 1 |
//! | [`breakdown`] | where their time goes |
//! | [`results`] | figures that were written, read again: a check of them, and the page of papers |
//! | [`structures`] | all structures: memory and rates, a row each |
//! | [`table`], [`bars`], [`plot`] | how it is shown |

pub mod agreement;
pub mod bars;
pub mod breakdown;
pub mod fly_through;
pub mod kd;
pub mod kd_growth;
pub mod mbvh;
pub mod measure;
pub mod plot;
pub mod ray_sets;
pub mod renders;
pub mod results;
pub mod structures;
pub mod table;
#[cfg(test)]
mod test_scene;
