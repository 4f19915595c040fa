/** First bytes of files that are no scenes. A number at the start of rows has them once in 2²⁸. */
export const OTHER_FILES: readonly { readonly pattern: RegExp; readonly message: string }[] = [
  {
    pattern: /^(?:\x89PNG|\xff\xd8\xff[\xc0-\xfe]|RIFF....WEBP|GIF8|II\*\0|MM\0\*)/s,
    message: 'it is an image; give the PLY itself',
  },
  { pattern: /^(?:\x7fELF|MZ\x90\0|[\xce\xcf]\xfa\xed\xfe|\0asm)/, message: 'it is a program, and no scene' },
  {
    pattern: /^(?:7z\xbc\xaf|\xfd7zXZ|BZh\d1AY&SY|Rar!)/,
    message: 'it is an archive of a kind that is not read; unpack it first',
  },
  {
    // biome-ignore lint/suspicious/noControlCharactersInRegex: Matroska begins with one
    pattern: /^(?:%PDF|SQLite|\x89HDF|\x93NUMPY|LASF|RIFF|OggS|\x1aE\xdf\xa3|....ftyp)/s,
    message: 'it is a document, a recording or a table of data, and no scene',
  },
];
