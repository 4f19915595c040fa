// The renderer of KeKsBoTer/web-splat; web-splat/build.sh compiles it with an interface for pages.

import init, { CanvasRenderer } from 'peer-source/lab/web_splat_peer.js';
import { cameraAxes } from '../src/peers/adapter.ts';

export const formats = ['ply'];

/** @type {import('../src/peers/adapter.ts').LoadPeer} */
export default async function loadWebSplat({ canvas, url }) {
  await init();
  const bytes = new Uint8Array(await (await fetch(url)).arrayBuffer());
  const renderer = await CanvasRenderer.load(canvas, inTrainingOrder(bytes));
  return {
    note: 'without its window; culls what has its middle outside of 1.2 times the image; loads include putting rows in order',
    setCamera: (by) => {
      const { right, down, forward } = cameraAxes(by);
      const rotation = [0, 1, 2].flatMap((i) => [right[i], down[i], forward[i]]);
      const halfHeight = Math.tan((by.fovYDegrees * Math.PI) / 360);
      const fovX = 2 * Math.atan((halfHeight * canvas.width) / canvas.height);
      const fovY = 2 * Math.atan(halfHeight);
      renderer.set_camera(by.position, rotation, fovX, fovY, by.near, by.far);
    },
    draw: () => renderer.render(),
    figures: () => ({ splats: renderer.splats() }),
  };
}

/** Its reader takes each row as training writes it, with normals, despite the header. */
function inTrainingOrder(ply) {
  const end = 'end_header\n';
  const text = new TextDecoder('latin1').decode(ply.subarray(0, 8192));
  const header = text.slice(0, text.indexOf(end));
  const found = [...header.matchAll(/^property float (\w+)$/gm)].map(([, name]) => name);
  const rest = found.filter((name) => name.startsWith('f_rest_')).map((_, i) => `f_rest_${i}`);
  const fixed = ['x', 'y', 'z', 'nx', 'ny', 'nz', 'f_dc_0', 'f_dc_1', 'f_dc_2'];
  const shape = ['opacity', 'scale_0', 'scale_1', 'scale_2', 'rot_0', 'rot_1', 'rot_2', 'rot_3'];
  const names = [...fixed, ...rest, ...shape];
  if (found.join() === names.join()) return ply;
  if (!header.includes('format binary_little_endian') || /^property (?!float )/m.test(header))
    throw new Error('web-splat takes binary PLY of floats alone, little endian.');

  const [, splats] = /^element vertex (\d+)$/m.exec(header);
  const properties = names.map((name) => `property float ${name}\n`).join('');
  const head = new TextEncoder().encode(
    `ply\nformat binary_little_endian 1.0\nelement vertex ${splats}\n${properties}${end}`,
  );
  const rows = new DataView(ply.buffer, header.length + end.length);
  const columns = names.map((name) => found.indexOf(name));
  const ordered = new Uint8Array(head.length + 4 * names.length * splats);
  ordered.set(head);
  const view = new DataView(ordered.buffer, head.length);
  for (let splat = 0, to = 0; splat < splats; splat++)
    for (const column of columns) {
      if (column >= 0) view.setUint32(to, rows.getUint32(4 * (splat * found.length + column)));
      to += 4;
    }
  return ordered;
}
