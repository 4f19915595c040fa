// A thread that draws a scene by one camera in float64. JavaScript: Node and packs run it as it is.
import { parentPort } from 'node:worker_threads';
import { perspectiveCamera, readSplats } from '@websplatter/core';
import { renderReference } from '@websplatter/core/reference';
import { serve } from '@websplatter/core/write';
import { openFile } from '@websplatter/node';

const TASKS = {
  async draw(/** @type {import('./pictures.ts').ReferenceRequest} */ request) {
    const { file, camera, widthPx, heightPx } = request;
    const set = await readSplats(await openFile(file), { name: file, shPrecision: 'f32' });
    return renderReference({
      clouds: [{ set }],
      camera: perspectiveCamera({ ...camera, aspect: widthPx / heightPx }),
      widthPx,
      heightPx,
    }).data;
  },
};

serve(TASKS, parentPort);
