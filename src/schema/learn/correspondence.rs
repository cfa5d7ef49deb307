//! What meshes have to have in common for their nodes to correspond.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::schema::wire::canonical::hex;
use mechanics::learning::measures::carried_by;
use mechanics::prediction::Scene;

/// SHA-256 of what numbers the nodes of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CorrespondenceDocument {
    /// Of the nodes of each cell.
    pub cells: String,
    /// Of the nodes of the skin, in its order.
    pub skin: String,
    /// Of the segments in their order, with the name and the nodes of each.
    pub bone: String,
}

impl CorrespondenceDocument {
    pub fn new(scene: &Scene) -> Self {
        let cells = &scene.mesh.cells;
        let mut sums = [(); 3].map(|()| Sha256::new());
        (0..cells.len()).for_each(|cell| add(&mut sums[0], cells.nodes(cell)));
        add(&mut sums[1], scene.skin.nodes());
        for (number, segment) in scene.segments.iter().enumerate() {
            sums[2].update(segment.name.as_bytes());
            add(&mut sums[2], &carried_by(scene, number));
        }
        let [cells, skin, bone] = sums.map(|sum| hex(&sum.finalize()));
        CorrespondenceDocument { cells, skin, bone }
    }

    /// What of it is not as in another: `cells`, `skin` or `bone`.
    pub fn difference(&self, other: &Self) -> Option<&'static str> {
        let parts = [
            ("cells", &self.cells, &other.cells),
            ("skin", &self.skin, &other.skin),
            ("bone", &self.bone, &other.bone),
        ];
        parts.into_iter().find(|(_, own, other)| own != other).map(|(part, ..)| part)
    }
}

/// How many nodes, and each of them.
fn add(sum: &mut Sha256, nodes: &[u32]) {
    sum.update((nodes.len() as u64).to_le_bytes());
    nodes.iter().for_each(|node| sum.update(node.to_le_bytes()));
}
