/** Scene formats without a reader, with advice how to get a PLY. */
export const UNREAD = {
  usd: 'it is a scene in USD, which is not read; export a PLY from the program that made it',
  numpy:
    'it is a file of NumPy arrays, whose names and meanings depend on the program; export a PLY there (gsplat: export_splats)',
  pytorch: "it is a PyTorch checkpoint, not a scene yet; export a PLY with the trainer's own command",
  lcc: 'it is the index of an XGRIDS scene (.lcc), which is not read; export a PLY from LCC Studio, or convert it with "splat-transform scene.lcc scene.ply"',
  gsplatPng:
    'it is a folder of PNGs by gsplat (PngCompression), which is not read; decompress it in gsplat, and write a PLY with export_splats',
} as const;

/** Signatures of files that are not scenes. Random float32 rows match one with a probability of 2⁻²⁸. */
export const OTHER_FILES: readonly { readonly pattern: RegExp; readonly message: string }[] = [
  {
    pattern: /^(?:\x89PNG|\xff\xd8\xff[\xc0-\xfe]|RIFF....WEBP|GIF8|II\*\0|MM\0\*)/s,
    message: 'it is an image, not a splat file',
  },
  { pattern: /^PXR-USDC/, message: UNREAD.usd },
  { pattern: /^\x93NUMPY/, message: UNREAD.numpy },
  {
    pattern: /^(?:b3dm|i3dm|pnts|cmpt)/,
    message:
      'it is content of 3D Tiles of a kind that has no splats; open one of the .glb files of the tileset',
  },
  {
    pattern: /^(?:Kaydara FBX Binary|BLENDER|DRACO|ASTM-E57|LASF)/,
    message:
      'it is a mesh or a point scan (FBX, Blender, Draco, E57 or LAS), not splats; splats come from training',
  },
  {
    pattern: /^(?:\x7fELF|MZ\x90\0|[\xce\xcf]\xfa\xed\xfe|\0asm)/,
    message: 'it is a program, not a splat file',
  },
  {
    pattern: /^(?:7z\xbc\xaf|\xfd7zXZ|BZh\d1AY&SY|Rar!)/,
    message: 'it is an archive of a kind that is not read; unpack it first',
  },
  {
    // biome-ignore lint/suspicious/noControlCharactersInRegex: the signature of Matroska begins with one
    pattern: /^(?:%PDF|SQLite|\x89HDF|RIFF|OggS|\x1aE\xdf\xa3|....ftyp)/s,
    message: 'it is a document, a recording or a table of data, not a splat file',
  },
];
