// Records of zip archives (PKWARE's APPNOTE 6.3): signatures, lengths, and where their fields begin.

/** Before each file. */
export const LOCAL_HEADER = {
  signature: 0x04034b50,
  bytes: 30,
  version: 4,
  flags: 6,
  date: 12,
  crc: 14,
  packedBytes: 18,
  unpackedBytes: 22,
  nameLength: 26,
  extraLength: 28,
} as const;

export const DIRECTORY_ENTRY = {
  signature: 0x02014b50,
  bytes: 46,
  writerVersion: 4,
  version: 6,
  flags: 8,
  method: 10,
  date: 14,
  crc: 16,
  packedBytes: 20,
  unpackedBytes: 24,
  nameLength: 28,
  extraLength: 30,
  commentLength: 32,
  localHeader: 42,
} as const;

export const DIRECTORY_END = {
  signature: 0x06054b50,
  bytes: 22,
  disks: 4,
  entriesHere: 8,
  entries: 10,
  directoryBytes: 12,
  directory: 16,
  commentLength: 20,
} as const;

/** The method of files that are not packed. */
export const STORED = 0;
