import type { FileFinding } from '../../data/errors.ts';

/** Scene formats without a reader, with advice how to get a PLY. */
export const UNREAD = {
  usd: ['is a scene in USD, which is not read', 'export a PLY from the program that made it'],
  numpy: [
    'is a file of NumPy arrays, whose names and meanings depend on the program',
    'export a PLY there (gsplat: export_splats)',
  ],
  pytorch: ['is a PyTorch checkpoint, not a scene yet', "export a PLY with the trainer's own command"],
  lcc: [
    'is the index of an XGRIDS scene (.lcc), which is not read',
    'export a PLY from LCC Studio, or convert it with "splat-transform scene.lcc scene.ply"',
  ],
  gsplatPng: [
    'is a folder of PNGs by gsplat (PngCompression), which is not read',
    'decompress it in gsplat, and write a PLY with export_splats',
  ],
} satisfies Record<string, FileFinding>;

/** A kind of file, told by its first bytes. */
export type OtherFile = readonly [pattern: RegExp, ...FileFinding];

/** Signatures of files that are not scenes. Random float32 rows match one with a probability of 2⁻²⁸. */
export const OTHER_FILES: readonly OtherFile[] = [
  [/^(?:\x89PNG|\xff\xd8\xff[\xc0-\xfe]|RIFF....WEBP|GIF8|II\*\0|MM\0\*)/s, 'is an image, not a splat file'],
  [/^PXR-USDC/, ...UNREAD.usd],
  [/^\x93NUMPY/, ...UNREAD.numpy],
  [
    /^(?:b3dm|i3dm|pnts|cmpt)/,
    'is content of 3D Tiles of a kind that has no splats',
    'open one of the .glb files of the tileset',
  ],
  [
    /^(?:Kaydara FBX Binary|BLENDER|DRACO|ASTM-E57|LASF)/,
    'is a mesh or a point scan (FBX, Blender, Draco, E57 or LAS), not splats',
    'splats come from training',
  ],
  [/^(?:\x7fELF|MZ\x90\0|[\xce\xcf]\xfa\xed\xfe|\0asm)/, 'is a program, not a splat file'],
  [
    /^(?:7z\xbc\xaf|\xfd7zXZ|BZh\d1AY&SY|Rar!)/,
    'is an archive of a kind that is not read',
    'unpack it first',
  ],
  [
    // biome-ignore lint/suspicious/noControlCharactersInRegex: the signature of Matroska begins with one
    /^(?:%PDF|SQLite|\x89HDF|RIFF|OggS|\x1aE\xdf\xa3|....ftyp)/s,
    'is a document, a recording or a table of data, not a splat file',
  ],
];
