//! The files of the scene that is written: each is read once, and each mesh made once, however many shapes refer to
//! it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use super::WriteError;
use crate::files::Files;
use crate::image::{self, Image};
use crate::ir::{MeshFile, Scene, parts};
use crate::mesh::{self, Mesh, MeshOptions};

pub(super) struct Sources<'a> {
    files: &'a dyn Files,
    bytes: RefCell<HashMap<PathBuf, Arc<Vec<u8>>>>,
    /// By the file and how it is read.
    meshes: RefCell<HashMap<String, Rc<LoadedMesh>>>,
    /// What is known of files, by the name of the question.
    facts: RefCell<HashMap<(&'static str, PathBuf), bool>>,
    /// The last one only: decoded pictures are many times their files, and who asks twice asks twice in a row.
    image: RefCell<Option<(PathBuf, Rc<Image>)>>,
}

/// A mesh, and what is known of its file beside.
pub(super) struct LoadedMesh {
    pub mesh: Rc<Mesh>,
    /// Attributes of the file that the mesh lacks, with their number of components.
    pub skipped: Vec<(String, usize)>,
    /// Whether all faces of a PLY file are triangles, as its head announces, and all normals directions.
    pub plain: bool,
}

impl<'a> Sources<'a> {
    pub fn new(files: &'a dyn Files) -> Self {
        let (bytes, meshes) = Default::default();
        Self { files, bytes, meshes, facts: RefCell::default(), image: RefCell::default() }
    }

    /// Whether all meshes and pictures of the scene may be read; nothing is opened.
    pub fn check(&self, scene: &Scene) -> Result<(), WriteError> {
        let mut paths: Vec<&Path> = Vec::new();
        parts(scene).for_each(|part| part.files(&mut |path| paths.push(path)));
        paths.sort_unstable();
        paths.dedup();
        let refused = |path: &&Path| Some((path.to_path_buf(), self.files.check(path).err()?));
        let refused: Vec<_> = paths.iter().filter_map(refused).collect();
        if refused.is_empty() { Ok(()) } else { Err(WriteError::Unreadable(refused)) }
    }

    pub fn read(&self, path: &Path) -> Result<Arc<Vec<u8>>, WriteError> {
        if let Some(bytes) = self.bytes.borrow().get(path) {
            return Ok(bytes.clone());
        }
        let fail = |error| WriteError::Io { path: path.to_path_buf(), error };
        let bytes = Arc::new(self.files.read(path).map_err(fail)?);
        self.bytes.borrow_mut().insert(path.to_path_buf(), bytes.clone());
        Ok(bytes)
    }

    pub fn is(&self, name: &'static str, path: &Path, so: fn(&[u8]) -> bool) -> Result<bool, WriteError> {
        let key = (name, path.to_path_buf());
        if let Some(known) = self.facts.borrow().get(&key) {
            return Ok(*known);
        }
        let found = so(&self.read(path)?);
        self.facts.borrow_mut().insert(key, found);
        Ok(found)
    }

    /// The bytes of a file if they were read.
    pub fn take(&self, path: &Path) -> Option<Arc<Vec<u8>>> {
        self.bytes.borrow_mut().remove(path)
    }

    pub fn mesh(&self, file: &MeshFile) -> Result<Rc<LoadedMesh>, WriteError> {
        let key = format!("{file:?}");
        if let Some(mesh) = self.meshes.borrow().get(&key) {
            return Ok(mesh.clone());
        }
        let options = MeshOptions {
            face_normals: file.face_normals,
            authored_normals: file.authored_normals,
            flip_tex_coords: file.flip_tex_coords,
            max_smooth_angle: file.max_smooth_angle,
        };
        let bytes = self.read(&file.path)?;
        let broken =
            |e: mesh::MeshError| WriteError::Asset { path: file.path.clone(), reason: e.to_string() };
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
        let announced = |line: &str| line.trim().strip_prefix("element face ")?.trim().parse().ok();
        let faces: Option<usize> = head.lines().find_map(announced);
        let mesh = mesh::read(file.format, &bytes, &options).map_err(broken)?;
        let plain = faces == Some(mesh.triangles.len()) && mesh.normals.iter().all(|n| sound(*n));
        let skipped = mesh::skipped(file.format, &bytes).map_err(broken)?;
        let loaded = Rc::new(LoadedMesh { mesh: Rc::new(mesh), skipped, plain });
        self.meshes.borrow_mut().insert(key, loaded.clone());
        Ok(loaded)
    }

    pub fn image(&self, path: &Path) -> Result<Rc<Image>, WriteError> {
        if let Some((known, image)) = self.image.borrow().as_ref()
            && known == path
        {
            return Ok(image.clone());
        }
        let broken =
            |e: image::ImageError| WriteError::Asset { path: path.to_path_buf(), reason: e.to_string() };
        let image = Rc::new(image::read(&self.read(path)?).map_err(broken)?);
        *self.image.borrow_mut() = Some((path.to_path_buf(), image.clone()));
        Ok(image)
    }
}

/// Whether a normal has a direction.
pub(super) fn sound(normal: [f32; 3]) -> bool {
    let square: f32 = normal.iter().map(|v| v * v).sum();
    square.is_normal()
}
