import { perspectiveCamera, SplatEngine } from '@websplatter/core';

const canvas = document.body.appendChild(document.createElement('canvas'));
const engine = await SplatEngine.create();
const view = engine.createView({ canvas });
const cloud = await engine.load('still-life.sog');

let turn = 0;

function draw() {
  const widthPx = Math.round(innerWidth * devicePixelRatio);
  const heightPx = Math.round(innerHeight * devicePixelRatio);
  const camera = perspectiveCamera({
    position: [1.4 * Math.sin(turn), 0.45, 1.4 * Math.cos(turn)],
    target: [0, 0.2, 0],
    fovYDegrees: 50,
    aspect: widthPx / heightPx,
  });
  view.render({ camera, clouds: [{ cloud }], widthPx, heightPx });
}

canvas.addEventListener('pointermove', ({ movementX, buttons }) => {
  if (buttons === 0) return;
  turn -= movementX * 0.005;
  draw();
});
addEventListener('resize', draw);
draw();
