// Builds the viewer as one file, embed.html, for use from a disk, in a frame, or on any host of single
// files. It contains only the small built-in scene, under the names of both: the large one is several
// times as large as everything else.
import { createRequire } from 'node:module';
import { oneFile } from './one-file.ts';

const { resolve } = createRequire(import.meta.url);

export default oneFile({
  page: 'index.html',
  fileName: 'embed.html',
  scene: resolve('@websplatter/scenes/files/still-life-small.spz'),
});
