// Builds the viewer as one file, embed.html, which works from a disk, in a frame, and wherever a
// single file can be put. Of the built-in scenes it has the small one alone, by the names of both:
// the other is several times as large as all the rest.
import { createRequire } from 'node:module';
import { oneFile } from './one-file.ts';

const { resolve } = createRequire(import.meta.url);

export default oneFile({
  page: 'index.html',
  fileName: 'embed.html',
  scene: resolve('@websplatter/scenes/files/still-life-small.spz'),
});
