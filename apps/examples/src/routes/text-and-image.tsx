import { OrbitControls } from '@react-three/drei';
import { splatsFromImage, splatsFromText } from '@websplatter/core/make';
import { SplatCanvas, Splats } from '@websplatter/react';
import { makeSplatData } from '@websplatter/react/own-data';
import { useState } from 'react';

/** A sunset, 192 × 108 pixels; a photograph would come from `createImageBitmap`. */
function paintSunset(): OffscreenCanvas {
  const canvas = new OffscreenCanvas(192, 108);
  const context = canvas.getContext('2d')!;
  const sky = context.createLinearGradient(0, 0, 0, 80);
  sky.addColorStop(0, '#2b3a7e');
  sky.addColorStop(0.6, '#e2725b');
  sky.addColorStop(1, '#ffd27d');
  context.fillStyle = sky;
  context.fillRect(0, 0, 192, 108);
  context.fillStyle = '#fff3c4';
  context.beginPath();
  context.arc(128, 64, 15, 0, 2 * Math.PI);
  context.fill();
  for (const [color, height, width] of [
    ['#5a3d5c', 76, 31],
    ['#2f2a44', 88, 19],
  ] as const) {
    context.fillStyle = color;
    for (let x = 0; x < 192; x++) context.fillRect(x, height + 8 * Math.sin(x / width), 1, 108);
  }
  return canvas;
}

export default function TextAndImage() {
  const [image] = useState(() => makeSplatData(splatsFromImage(paintSunset())));
  const [text] = useState(() => {
    const style = { font: 'Georgia, serif', weight: 700, sizePx: 96, color: '#ffe9b0' };
    return makeSplatData(splatsFromText('Splats', style));
  });
  return (
    <SplatCanvas flat frameloop="demand" camera={{ position: [0.35, 0.1, 1.5], fov: 50, near: 0.05 }}>
      <Splats src={image} />
      <Splats src={text} position={[-0.3, 0.15, 0.1]} scale={0.32} />
      <OrbitControls />
    </SplatCanvas>
  );
}
