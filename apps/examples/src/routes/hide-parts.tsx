import {
  SplatCanvas,
  type SplatCloudObject,
  type SplatData,
  type SplatSelection,
  Splats,
} from '@websplatter/react';
import { editsOf } from '@websplatter/react/own-data';
import { Suspense, useEffect, useRef, useState } from 'react';
import { Box3, Sphere, Vector3 } from 'three';

/** Middles of the round feet of the figures, which stand in a bow. */
const FEET = Array.from({ length: 7 }, (_, i) => {
  const angle = (i / 6 - 0.5) * 2.2;
  return new Vector3(0.62 * Math.sin(angle), -0.13, 0.75 - 0.62 * Math.cos(angle));
});

/**
 * Finds the rows of a figure: of its foot in a ball, and of its body in a box. A box as wide as the
 * foot would hold a part of the next foot, too.
 */
async function rowsOfFigure(data: SplatData, foot: Vector3): Promise<SplatSelection> {
  const rows = await data.rowsIn(new Sphere(foot, 0.11));
  const middle = new Vector3(foot.x, foot.y + 0.2, foot.z);
  const body = new Box3().setFromCenterAndSize(middle, new Vector3(0.15, 0.4, 0.15));
  rows.add(await data.rowsIn(body));
  return rows;
}

export default function HideParts() {
  const cloud = useRef<SplatCloudObject>(null);
  /** Rows of each figure; none until the file is loaded. */
  const [figures, setFigures] = useState<readonly SplatSelection[]>([]);
  const [isFaint, setFaint] = useState([false, true, false, true, true, false, false]);
  const faintRows = figures.reduce((sum, { size }, i) => sum + (isFaint[i] ? size : 0), 0);
  const toggle = (i: number) => setFaint((before) => before.with(i, !before[i]));
  useEffect(() => {
    const data = cloud.current?.data;
    if (!data || figures.length === 0) return;
    const edits = editsOf(data);
    edits.reset();
    for (const [i, rows] of figures.entries()) if (isFaint[i]) edits.set(rows, { opacities: [0.03] });
  }, [figures, isFaint]);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 0.5, 1.75], fov: 40, near: 0.05 }}>
        <Suspense>
          <Splats
            ref={cloud}
            src="figures.ply"
            onLoad={async (data) => {
              setFigures(await Promise.all(FEET.map((foot) => rowsOfFigure(data, foot))));
            }}
            onClick={async (event) => {
              const hit = await cloud.current?.pickAt(event);
              const clicked = figures.findIndex((rows) => hit && rows.has(hit.row));
              if (clicked >= 0) toggle(clicked);
            }}
          />
        </Suspense>
      </SplatCanvas>
      <form className="panel">
        {figures.map((_, i) => (
          <label key={FEET[i].x}>
            <input type="checkbox" checked={!isFaint[i]} onChange={() => toggle(i)} /> {i + 1}
          </label>
        ))}
        <output>{faintRows.toLocaleString('en')} rows are faint</output>
      </form>
    </>
  );
}
