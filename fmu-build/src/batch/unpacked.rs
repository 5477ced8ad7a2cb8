//! An FMU's files in a folder for the time of a batch.

use crate::project;
use anyhow::{Context, Result, bail, ensure};
use scene::message::{Clipped, Quoted};
use std::fs::{self, File};
use std::io::{Read, Seek, copy};
use std::path::{Path, PathBuf};

/// Bytes that an FMU may unpack to: 20 times the largest of this project, and nothing that fills a disk.
const MOST_BYTES: u64 = 1 << 30;

/// Ending of the file that is locked as long as the folder of its name is used.
const LOCK: &str = "lock";

/// A folder with the files of an FMU, removed in the end; where the process is killed, by the next one.
pub(crate) struct Unpacked {
    pub folder: PathBuf,
    lock: PathBuf,
    _held: File,
}

impl Unpacked {
    /// Unpacks an .fmu into a folder of cargo's.
    pub(crate) fn new(fmu: impl Read + Seek) -> Result<Self> {
        let above = project::target().join("batch");
        fs::create_dir_all(&above).with_context(|| format!("making {}", above.display()))?;
        remove_abandoned(&above);
        let folder = above.join(format!("fmu-{}", std::process::id()));
        let lock = folder.with_extension(LOCK);
        let held = File::create(&lock).with_context(|| format!("making {}", lock.display()))?;
        let unpacked = Self { folder, lock, _held: held };
        unpacked._held.lock().with_context(|| format!("locking {}", unpacked.lock.display()))?;
        unpack(fmu, &unpacked.folder, MOST_BYTES)?;
        Ok(unpacked)
    }
}

impl Drop for Unpacked {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
        let _ = fs::remove_file(&self.lock);
    }
}

/// Removes folders of processes that were killed: their locks are free.
fn remove_abandoned(above: &Path) {
    let Ok(entries) = fs::read_dir(above) else { return };
    for lock in entries.flatten().map(|entry| entry.path()) {
        let is_lock = lock.extension().is_some_and(|ending| ending == LOCK);
        if is_lock && File::open(&lock).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_dir_all(lock.with_extension(""));
            let _ = fs::remove_file(&lock);
        }
    }
}

/// Unpacks an archive of at most `most` bytes into a new folder.
fn unpack(fmu: impl Read + Seek, folder: &Path, most: u64) -> Result<()> {
    let mut archive = zip::ZipArchive::new(fmu).context("it is no .fmu, which is a zip archive")?;
    let said = archive.decompressed_size().unwrap_or(0);
    ensure!(said <= u128::from(most), "its files are {} MB, and at most {} MB are unpacked", said >> 20, most >> 20);
    let mut left = most;
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index)?;
        let name = entry.name()?.into_owned();
        let Some(path) = entry.enclosed_name().map(|name| folder.join(name)) else {
            bail!("{} in it is outside of the folder that it unpacks to", Quoted(&name));
        };
        if entry.is_dir() {
            fs::create_dir_all(&path).with_context(|| format!("making {}", path.display()))?;
            continue;
        }
        if let Some(above) = path.parent() {
            fs::create_dir_all(above).with_context(|| format!("making {}", above.display()))?;
        }
        let context = || format!("writing {}", path.display());
        let mut file = File::create(&path).with_context(context)?;
        // Counted as they come: an archive may say a size that is not the right one.
        let written = copy(&mut entry.by_ref().take(left + 1), &mut file).with_context(context)?;
        ensure!(
            written <= left,
            "its files are larger than {} MB, the most that is unpacked ({} of them until {})",
            most >> 20,
            index + 1,
            Clipped(&name)
        );
        left -= written;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Write};
    use zip::write::SimpleFileOptions;

    fn archive(files: &[(&str, usize)]) -> Cursor<Vec<u8>> {
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for (name, length) in files {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(&vec![b'0'; *length]).unwrap();
        }
        zip.finish().unwrap()
    }

    #[test]
    fn files_are_there_until_the_end_of_the_batch() {
        let unpacked = Unpacked::new(archive(&[("modelDescription.xml", 7), ("binaries/linux64/a.so", 9)])).unwrap();
        let (folder, lock) = (unpacked.folder.clone(), unpacked.lock.clone());
        assert_eq!(fs::read(folder.join("binaries/linux64/a.so")).unwrap(), b"000000000");
        // Another process cleans up, but not what is in use.
        remove_abandoned(folder.parent().unwrap());
        assert!(folder.is_dir());
        drop(unpacked);
        assert!(!folder.exists() && !lock.exists());
        // Left behind by a process that was killed.
        let killed = folder.with_file_name("fmu-killed");
        fs::create_dir_all(killed.join("resources")).unwrap();
        fs::write(killed.with_extension(LOCK), "").unwrap();
        remove_abandoned(folder.parent().unwrap());
        assert!(!killed.exists() && !killed.with_extension(LOCK).exists());
    }

    #[test]
    fn archives_that_are_too_large_or_reach_elsewhere_are_refused() {
        let folder = std::env::temp_dir().join(format!("batch-unpacked-{}", std::process::id()));
        let told = |files: &[(&str, usize)], most: u64| {
            let told = unpack(archive(files), &folder, most).map_err(|error| format!("{error:#}"));
            let _ = fs::remove_dir_all(&folder);
            told
        };
        let megabyte = 1 << 20;
        let files = [("a", megabyte), ("resources/b", megabyte)];
        assert_eq!(told(&files, 2 << 20), Ok(()));
        let refused = told(&files, (2 << 20) - 1).unwrap_err();
        assert_eq!(refused, "its files are 2 MB, and at most 1 MB are unpacked");
        // An archive that says less than it has, in its entries and in its directory.
        let mut bytes = archive(&[("a", 4 * megabyte)]).into_inner();
        let said = (4 * megabyte as u32).to_le_bytes();
        let places: Vec<usize> = (0..bytes.len() - 4).filter(|at| bytes[*at..at + 4] == said).collect();
        places.iter().for_each(|at| bytes[*at..at + 4].copy_from_slice(&9_u32.to_le_bytes()));
        assert!(!places.is_empty());
        assert!(unpack(Cursor::new(bytes), &folder, 100).is_err());
        assert!(fs::metadata(folder.join("a")).is_ok_and(|file| file.len() <= 101));
        let _ = fs::remove_dir_all(&folder);
        assert!(told(&[("../a", 1)], 10).unwrap_err().contains("outside"));
        assert!(unpack(Cursor::new(b"no archive".to_vec()), &folder, 10).unwrap_err().to_string().contains("no .fmu"));
    }
}
