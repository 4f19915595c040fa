import { fetchAway, type LoadPeer, type PeerFormats } from '../adapter.ts';

export const formats: PeerFormats = 'any';

/**
 * Draws nothing: fetches the file, throws its bytes away and clears the canvas. Its times are the
 * floor under all others. `?api=webgl2` clears by WebGL.
 */
const loadFloor: LoadPeer = async ({ canvas, url, options }) => {
  const clear = options.get('api') === 'webgl2' ? webglClear(canvas) : await webgpuClear(canvas);
  await fetchAway(url);
  return { note: 'fetches the file and clears the canvas', setCamera: () => {}, draw: clear };
};
export default loadFloor;

function webglClear(canvas: HTMLCanvasElement): () => void {
  const gl = canvas.getContext('webgl2', { antialias: false });
  if (!gl) throw new Error('There is no WebGL 2.');
  return () => gl.clear(gl.COLOR_BUFFER_BIT);
}

async function webgpuClear(canvas: HTMLCanvasElement): Promise<() => void> {
  const adapter = await navigator.gpu?.requestAdapter();
  const context = canvas.getContext('webgpu');
  if (!adapter || !context) throw new Error('There is no WebGPU.');
  const device = await adapter.requestDevice();
  context.configure({ device, format: navigator.gpu.getPreferredCanvasFormat(), alphaMode: 'opaque' });
  return () => {
    const encoder = device.createCommandEncoder();
    const view = context.getCurrentTexture().createView();
    encoder.beginRenderPass({ colorAttachments: [{ view, loadOp: 'clear', storeOp: 'store' }] }).end();
    device.queue.submit([encoder.finish()]);
  };
}
