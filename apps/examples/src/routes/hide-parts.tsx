import {
  SplatCanvas,
  type SplatCloudObject,
  type SplatData,
  SplatSelection,
  Splats,
} from '@websplatter/react';
import { editsOf } from '@websplatter/react/own-data';
import { Suspense, useRef, useState } from 'react';
import { Box3, Vector3 } from 'three';

const FIGURES = 7;
const FAINT_AT_FIRST = [1, 3, 4];

/** Finds the rows of each figure: they stand in a bow, each in a box of its own. */
function rowsOfFigures(data: SplatData): Promise<SplatSelection[]> {
  const boxes = Array.from({ length: FIGURES }, (_, i) => {
    const angle = (i / (FIGURES - 1) - 0.5) * 2.2;
    const foot = new Vector3(0.62 * Math.sin(angle), 0, 0.75 - 0.62 * Math.cos(angle));
    return new Box3().setFromCenterAndSize(foot, new Vector3(0.22, 1, 0.22));
  });
  return Promise.all(boxes.map((box) => data.rowsIn(box)));
}

export default function HideParts() {
  const cloud = useRef<SplatCloudObject>(null);
  const [figures, setFigures] = useState<readonly SplatSelection[]>([]);
  const [faint] = useState(() => new SplatSelection());
  const [count, setCount] = useState(0);
  const isFaint = ([row]: Iterable<number>) => faint.has(row);
  const show = (data: SplatData) => {
    const edits = editsOf(data);
    edits.reset();
    edits.set(faint, { opacities: [0.03] });
    setCount(faint.size);
  };
  const toggle = (figure: SplatSelection | undefined) => {
    const data = cloud.current?.data;
    if (!figure || !data) return;
    faint.toggle(figure);
    show(data);
  };
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 0.5, 1.75], fov: 40, near: 0.05 }}>
        <Suspense>
          <Splats
            ref={cloud}
            src="figures.ply"
            onLoad={async (data) => {
              const found = await rowsOfFigures(data);
              setFigures(found);
              for (const i of FAINT_AT_FIRST) faint.add(found[i]);
              show(data);
            }}
            onClick={async (event) => {
              const hit = await cloud.current?.pickAt(event);
              if (hit) toggle(figures.find((figure) => figure.has(hit.row)));
            }}
          />
        </Suspense>
      </SplatCanvas>
      <form className="panel">
        {figures.map((figure, i) => (
          <label key={[...figure][0]}>
            <input type="checkbox" checked={!isFaint(figure)} onChange={() => toggle(figure)} /> {i + 1}
          </label>
        ))}
        <output>{count.toLocaleString('en')} rows are faint</output>
      </form>
    </>
  );
}
