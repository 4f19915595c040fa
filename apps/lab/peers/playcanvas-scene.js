// PlayCanvas's component for splats, whichever release `pc` is.

/** PlayCanvas on a canvas, with WebGPU and nothing else than splats. */
export async function playCanvasScene(pc, canvas) {
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
  const camera = new pc.Entity('camera');
  camera.addComponent('camera', { clearColor: new pc.Color(0, 0, 0, 1) });
  app.root.addChild(camera);

  let isReady = false;
  app.systems.gsplat.on('frame:ready', (_camera, _layer, ready, loadingCount) => {
    isReady = ready && loadingCount === 0;
  });
  return {
    app,
    /** Resolves when the file is there; of a scene that streams, its metadata. */
    load: async (url, fileName) => {
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
    },
    /** Whether the last frame had all that it wanted, by PlayCanvas's own account. */
    isReady: () => isReady,
    peer: {
      setCamera: ({ position, target, up, fovYDegrees, near, far }) => {
        camera.setPosition(...position);
        camera.lookAt(new pc.Vec3(...target), new pc.Vec3(...up));
        Object.assign(camera.camera, { fov: fovYDegrees, nearClip: near, farClip: far });
      },
      draw: () => app.tick(performance.now()),
      figures: () => ({ renderer: app.scene.gsplat.currentRenderer, splats: app.stats.frame.gsplats }),
    },
  };
}
