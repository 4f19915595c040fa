import { cameraAt, MODELS } from '../cameras.mjs';
import { drawFrame, effectsOf, lastImage, noteEngine } from '../draw-frame.mjs';
import { randomPly } from '../random-ply.mjs';
import { readTexture } from '../read-texture.mjs';

/** One view over time: what each frame reuses of the one before must not show. Drawn on a canvas, with a background. */
export async function sequence({ checkout, size, test, note }) {
  const { core, device, effects } = checkout;
  const { widthPx, heightPx } = size;
  const aspect = widthPx / heightPx;
  const camera = (change) => cameraAt(core, aspect, change);

  for (const accuracy of ['balanced', 'reference']) {
    await test(accuracy, async (record) => {
      const engine = await core.SplatEngine.create({ device, accuracy });
      const one = await engine.load(randomPly({ count: 1500, seed: 41 }), { name: 'one' });
      const other = await engine.load(randomPly({ count: 900, seed: 42, shDegree: 2 }), { name: 'other' });
      const canvas = new TextureCanvas();
      const view = engine.createView({ canvas });
      const tinted = (amount) => [{ cloud: one, effects: [effects.tint([1, amount, 0.5])] }];

      let frame = { camera: camera(), clouds: [{ cloud: one }], ...size };
      // Each changes what it names and keeps the rest.
      const steps = {
        first: {},
        moved: { camera: camera({ moved: 0.1 }) },
        turned: { camera: camera({ moved: 0.1, turned: 0.1 }) },
        'turned again': { camera: camera({ moved: 0.1, turned: 0.25 }) },
        tinted: { clouds: tinted(0.8) },
        'tinted otherwise': { clouds: tinted(0.2) },
        'turned while tinted': { camera: camera({ moved: 0.1, turned: -0.1 }) },
        resized: { widthPx: widthPx - 13, heightPx: heightPx + 9 },
        'another background': { background: [0.2, 0.5, 0.9] },
        'nothing changed': {},
        forced: { force: true },
        clipped: { force: false, clouds: [{ cloud: one, effects: [clipped(effects, 0.3)] }] },
        'clipped farther': { clouds: [{ cloud: one, effects: [clipped(effects, -0.2)] }] },
        'not clipped': { clouds: [{ cloud: one }], ...size },
        'two clouds': { clouds: [{ cloud: one }, { cloud: other, modelMatrix: MODELS.mirrored }] },
        'two turned': { camera: camera({ moved: 0.1, turned: 0.4 }) },
        'one faded': { clouds: [{ cloud: one, opacity: 0.3 }, { cloud: other }] },
        'in another order': { clouds: [{ cloud: other }, { cloud: one }] },
        'of degree 1': { clouds: [{ cloud: other, shDegree: 1 }, { cloud: one }] },
        'at half the resolution': { accuracy: { preset: accuracy, resolutionScale: 0.5 } },
        'half and turned': { camera: camera({ moved: 0.1, turned: 0.2 }) },
        'with short keys': { accuracy: { preset: accuracy, sortKeyBits: 16 } },
        'as first': { camera: camera(), clouds: [{ cloud: one }], accuracy, background: [0, 0, 0] },
      };
      for (const [index, [name, change]] of Object.entries(steps).entries()) {
        const numbered = `${String(index + 1).padStart(2, '0')} ${name}`;
        frame = { ...frame, ...change };
        await drawFrame(checkout, view, frame);
        record.image(numbered, await lastImage(view));
        record.image(`${numbered}, canvas`, await readTexture(device, canvas.texture));
        record.value(`${numbered}, effects`, effectsOf(view));
      }
      noteEngine((name, value) => note(`${accuracy}/${name}`, value), engine);
      engine.destroy();
    });
  }
}

function clipped({ clip }, x) {
  return clip({ volumes: [{ shape: 'plane', point: [x, 0, 0], normal: [-1, 0.2, 0] }], softEdge: 0.05 });
}

/** What a view needs of a canvas, without a page. */
class TextureCanvas {
  width = 0;
  height = 0;
  /** What was drawn on last. */
  texture = null;
  #configuration = null;

  getContext() {
    return {
      canvas: this,
      configure: (configuration) => {
        this.#configuration = configuration;
      },
      unconfigure: () => {},
      getCurrentTexture: () => {
        const { device, format } = this.#configuration;
        this.texture = device.createTexture({
          size: [this.width, this.height],
          format,
          usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
        });
        return this.texture;
      },
    };
  }
}
