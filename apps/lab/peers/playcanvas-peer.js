// PlayCanvas's component for splats, whichever release `pc` is.
import { nextTask } from '../src/peers/adapter.ts';

/** Told by the names of files. */
export const formats = ['ply', 'compressed-ply', 'sog'];

const MAX_FRAMES_TO_LOAD = 600;

/**
 * `?exact` draws all that the engine leaves out by default: small and faint splats, and colours of
 * small turns.
 *
 * @param renderer one of the engine's constants GSPLAT_RENDERER_…; by default its own choice
 * @type {(pc: any, renderer?: string) => import('../src/peers/adapter.ts').LoadPeer}
 */
export const playCanvasPeer =
  (pc, renderer) =>
  async ({ canvas, url, fileName, options }) => {
    const { width, height } = canvas;
    const graphicsDevice = await pc.createGraphicsDevice(canvas, {
      deviceTypes: ['webgpu'],
      antialias: false,
    });
    if (!graphicsDevice.isWebGPU) throw new Error('PlayCanvas has fallen back to WebGL.');
    const settings = Object.assign(new pc.AppOptions(), {
      graphicsDevice,
      componentSystems: [pc.CameraComponentSystem, pc.GSplatComponentSystem],
      resourceHandlers: [pc.TextureHandler, pc.ContainerHandler, pc.GSplatHandler],
    });
    const app = new pc.AppBase(canvas);
    app.init(settings);
    app.setCanvasFillMode(pc.FILLMODE_NONE, width, height);
    app.setCanvasResolution(pc.RESOLUTION_FIXED, width, height);
    // Frames are drawn when the bench asks for them alone.
    app.requestAnimationFrame = () => {};
    app.start();
    if (renderer) app.scene.gsplat.renderer = pc[renderer];
    if (options.has('exact'))
      Object.assign(app.scene.gsplat, { minPixelSize: 0, minContribution: 0, colorUpdateAngle: 0 });

    const camera = new pc.Entity('camera');
    camera.addComponent('camera', { clearColor: new pc.Color(0, 0, 0, 1) });
    app.root.addChild(camera);
    const asset = new pc.Asset('scene', 'gsplat', { url, filename: fileName });
    app.assets.add(asset);
    await new Promise((resolve, reject) => {
      asset.ready(resolve);
      asset.once('error', (error) => reject(new Error(String(error))));
      app.assets.load(asset);
    });
    const entity = new pc.Entity('splats');
    entity.addComponent('gsplat', { asset });
    app.root.addChild(entity);

    let isReady = false;
    app.systems.gsplat.on('frame:ready', (_camera, _layer, ready, loadingCount) => {
      isReady = ready && loadingCount === 0;
    });
    const draw = () => app.tick(performance.now());
    for (let frame = 0; !isReady && frame < MAX_FRAMES_TO_LOAD; frame++) {
      draw();
      await nextTask();
    }
    if (!isReady) throw new Error(`PlayCanvas was not ready after ${MAX_FRAMES_TO_LOAD} frames.`);
    const chosen = options.has('exact') ? 'nothing left out' : 'defaults';
    return {
      note: renderer ? `${renderer}, ${chosen}` : chosen,
      setCamera: ({ position, target, up, fovYDegrees, near, far }) => {
        camera.setPosition(...position);
        camera.lookAt(new pc.Vec3(...target), new pc.Vec3(...up));
        Object.assign(camera.camera, { fov: fovYDegrees, nearClip: near, farClip: far });
      },
      draw,
      figures: () => ({ renderer: app.scene.gsplat.currentRenderer, splats: app.stats.frame.gsplats }),
    };
  };
