// The page's part of the recipe "In a worker".
const canvas = document.querySelector('canvas')!;
const offscreen = canvas.transferControlToOffscreen();
const worker = new Worker(new URL('./draw.ts', import.meta.url), { type: 'module' });
worker.addEventListener('message', ({ data }: MessageEvent<string>) => {
  document.title = data;
});
const src = new URL('a.ply', location.href).href;
const size = { widthPx: canvas.width, heightPx: canvas.height };
worker.postMessage({ canvas: offscreen, src, ...size }, [offscreen]);
