// Proves: the engine draws the frames of a file as it should draw the frames that were written, at 40 dB and more.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { SplatEngine } from '../../../create-engine.ts';
import { perspectiveCamera } from '../../../data/camera/camera.ts';
import { compareImages, renderReference } from '../../../reference/index.ts';
import { FIXED_RASTERIZER } from '../../../testing/fixed-rasterizer.ts';
import { framesFile } from '../../../testing/frames-file.ts';
import { framesOfMotion } from '../../../testing/frames-of-motion.ts';
import { draw } from '../../../testing/preset-engines.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { openFrames } from './open-frames.ts';

const SIZE = { widthPx: 64, heightPx: 48 };
const MIN_PSNR_DB = 40;

const camera = perspectiveCamera({
  position: [1.1, 0.6, 2.2],
  target: [0, 0, 0],
  fovYDegrees: 50,
  aspect: SIZE.widthPx / SIZE.heightPx,
});

gpuTest('frames are drawn as the splats that they were written from, in any order', async () => {
  const frames = framesOfMotion(randomSplats({ count: 900, shDegree: 1, logScales: [-4, -2.5] }), 20);
  const file = await openFrames(await framesFile(frames), { name: 'dance.frames' });
  const engine = await SplatEngine.create({ device: await shareTestDevice(), accuracy: FIXED_RASTERIZER });
  const view = engine.createView();
  try {
    for (const number of [19, 0, 11]) {
      const cloud = await engine.load(file.frames[number]);
      expect(cloud.name).toBe(`dance.frames, frame ${number}`);
      const image = await draw(view, { camera, clouds: [{ cloud }], ...SIZE });
      const expected = renderReference({ clouds: [{ set: frames[number] }], camera, ...SIZE });
      expect(compareImages(image, expected.data, SIZE).psnrDb).toBeGreaterThan(MIN_PSNR_DB);
      // Another frame is another picture.
      const other = renderReference({ clouds: [{ set: frames[(number + 10) % 20] }], camera, ...SIZE });
      expect(compareImages(image, other.data, SIZE).psnrDb).toBeLessThan(MIN_PSNR_DB);
      // From the file, once more.
      await engine.requestPrecision(cloud, { geometryPrecision: 'f32', shPrecision: 'f32' });
      const finer = await draw(view, { camera, clouds: [{ cloud }], ...SIZE });
      expect(compareImages(finer, expected.data, SIZE).psnrDb).toBeGreaterThan(MIN_PSNR_DB);
      cloud.destroy();
    }
  } finally {
    file.end();
    view.destroy();
  }
});
