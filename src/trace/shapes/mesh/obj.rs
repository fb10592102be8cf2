//! Meshes from Wavefront OBJ text.
//!
//! All groups and objects of the file become one mesh; polygons become fans of triangles; lines,
//! points and materials are left out. Normals and texture coordinates are kept if every part of the
//! file has them.

use glam::{DVec2, DVec3};
use tobj::{LoadError, LoadOptions, load_obj_buf};

use super::{MeshError, Points};

/// Reads OBJ text.
pub fn read(mut text: &[u8]) -> Result<Points, MeshError> {
    let options = LoadOptions {
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let no_materials = |_: &std::path::Path| Err(LoadError::OpenFileFailed);
    let (models, _) = load_obj_buf(&mut text, &options, no_materials)
        .map_err(|error| MeshError::Obj(error.to_string()))?;
    let mut points = Points {
        places: Vec::new(),
        triangles: Vec::new(),
        normals: Vec::new(),
        uv: Vec::new(),
    };
    let mut complete = (true, true);
    for model in &models {
        let mesh = &model.mesh;
        let first = points.places.len() as u32;
        let vectors = |list: &[f64]| -> Vec<DVec3> {
            list.chunks_exact(3)
                .map(|c| DVec3::new(c[0], c[1], c[2]))
                .collect()
        };
        points.places.extend(vectors(&mesh.positions));
        points.normals.extend(vectors(&mesh.normals));
        let uv = mesh.texcoords.chunks_exact(2);
        points.uv.extend(uv.map(|c| DVec2::new(c[0], c[1])));
        let corners = mesh.indices.chunks_exact(3);
        points
            .triangles
            .extend(corners.map(|c| [c[0] + first, c[1] + first, c[2] + first]));
        complete.0 &= points.normals.len() == points.places.len();
        complete.1 &= points.uv.len() == points.places.len();
    }
    if !complete.0 {
        points.normals.clear();
    }
    if !complete.1 {
        points.uv.clear();
    }
    Ok(points)
}
