//! Models, textures, scene files and pictures, to and from the disk.
