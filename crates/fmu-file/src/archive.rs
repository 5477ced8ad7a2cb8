//! The .fmu as a zip file whose bytes depend on its content alone.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Cursor, Read, Write};
use std::path::Path;

use anyhow::{Context, Result};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipArchive, ZipWriter};

/// Files of an FMU: path with forward slashes, and bytes. Sorted by path.
pub type Files = BTreeMap<String, Vec<u8>>;

/// Packs the files in the order of their paths, all with the same time and permissions, so that the same files
/// give the same bytes anywhere and at any time. FMI 2.0 allows no other compression than deflate.
///
/// # Errors
/// Where a file is too large for a zip file.
pub fn pack(files: &Files) -> Result<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (path, bytes) in files {
        let permissions = if path.starts_with("binaries/") { 0o755 } else { 0o644 };
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .compression_level(Some(9))
            .last_modified_time(DateTime::default())
            .system(System::Unix)
            .unix_permissions(permissions);
        zip.start_file(path.as_str(), options).with_context(|| format!("packing {path}"))?;
        zip.write_all(bytes).with_context(|| format!("packing {path}"))?;
    }
    Ok(zip.finish().context("packing")?.into_inner())
}

/// Bytes of one file of an .fmu.
///
/// # Errors
/// Where it cannot be read, is no zip file, or has no such file.
pub fn entry(fmu: &Path, path: &str) -> Result<Vec<u8>> {
    let context = || format!("reading {path} in {}", fmu.display());
    let mut archive = ZipArchive::new(File::open(fmu).with_context(context)?).with_context(context)?;
    let mut bytes = Vec::new();
    archive.by_name(path).with_context(context)?.read_to_end(&mut bytes).with_context(context)?;
    Ok(bytes)
}

/// Files of an archive; entries that are folders are left out.
pub(crate) fn unpack(bytes: &[u8]) -> Result<Files> {
    let mut zip = ZipArchive::new(Cursor::new(bytes)).context("reading the zip file")?;
    let mut files = Files::new();
    for index in 0..zip.len() {
        let mut file = zip.by_index(index).context("reading the zip file")?;
        let name = file.name().context("reading the zip file")?.into_owned();
        if !name.ends_with('/') {
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).with_context(|| format!("unpacking {name}"))?;
            files.insert(name, bytes);
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {

    use super::*;

    fn files() -> Files {
        let noise = (0..100_000_u32).map(|index| (index.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        Files::from([
            ("modelDescription.xml".to_owned(), b"<a/>".repeat(1000)),
            ("binaries/linux64/SlidingContact.so".to_owned(), noise),
            ("empty".to_owned(), vec![]),
        ])
    }

    #[test]
    fn what_is_packed_is_unpacked_sorted_and_deflated() {
        let bytes = pack(&files()).unwrap();
        let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        let names: Vec<String> = zip.file_names().map(|name| name.unwrap().into_owned()).collect();
        assert_eq!(names, files().into_keys().collect::<Vec<_>>());
        for (name, expected) in files() {
            let mut file = zip.by_name(&name).unwrap();
            assert_eq!(file.compression(), CompressionMethod::Deflated);
            let mut found = Vec::new();
            file.read_to_end(&mut found).unwrap();
            assert_eq!(found, expected, "{name}");
        }
    }

    #[test]
    fn the_bytes_do_not_depend_on_the_time() {
        let first = pack(&files()).unwrap();
        // The resolution of times in a zip file is two seconds.
        std::thread::sleep(std::time::Duration::from_millis(2100));
        assert!(first == pack(&files()).unwrap());
    }
}
