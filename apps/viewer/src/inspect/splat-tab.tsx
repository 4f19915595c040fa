import type { SplatSet } from '@websplatter/core';
import type { TracedSplat } from '@websplatter/core/reference';
import { TextButton } from '@websplatter/kit/controls';
import { formatCount } from '@websplatter/kit/format';
import { type FormEvent, type ReactNode, useId } from 'react';
import { useStore } from 'zustand';
import type { InspectedSplat, PixelShare } from '../state/inspecting.ts';
import type { Vec3 } from '../state/vec3.ts';
import type { InspectProps } from './inspection.ts';
import { formatFigure } from './length-scale.ts';

/** Names of colours, by the highest degree that they include. */
const UP_TO = ['Base', '+ degree 1', '+ degree 2', '+ degree 3'];

/** One splat: its values in the file, its appearance, and its share of a pixel. */
export function SplatTab({ store, inspection }: InspectProps) {
  const splat = useStore(store, (state) => state.inspecting.splat);
  return (
    <div className="inspect-sections">
      {!splat && <p>Click a splat in the picture to see its values.</p>}
      {splat && <Found store={store} splat={splat} />}
      <Finder inspection={inspection} store={store} />
    </div>
  );
}

function Finder({ inspection }: InspectProps) {
  const id = useId();
  const onSubmit = (event: FormEvent<HTMLFormElement>) => {
    event.preventDefault();
    const row = event.currentTarget.elements.namedItem('row') as HTMLInputElement;
    if (row.value !== '') void inspection.splats.showRow(row.valueAsNumber);
  };
  return (
    <div className="inspect-actions">
      <TextButton testId="inspect-middle" onClick={() => inspection.pickMiddle()}>
        Inspect the middle of the picture
      </TextButton>
      <form onSubmit={onSubmit}>
        <label htmlFor={id}>Row</label>
        <input id={id} name="row" type="number" min={0} step={1} data-testid="inspect-row-input" />
        <button type="submit" className="text-button outlined">
          Go
        </button>
      </form>
    </div>
  );
}

function Found({ store, splat }: Pick<InspectProps, 'store'> & { splat: InspectedSplat }) {
  const cloudCount = useStore(store, (state) => state.scene?.clouds ?? 1);
  const { row, cloudIndex, set, seen, share } = splat;
  return (
    <>
      <h3 data-testid="inspect-row">
        Row {formatCount(row)}
        {cloudCount > 1 && ` of cloud ${cloudIndex + 1}`}
      </h3>
      {share && <Share share={share} />}
      {set && <Values set={set} />}
      {set && <Seen seen={seen} />}
    </>
  );
}

function Share({ share }: { share: PixelShare }) {
  const { alpha, weight, totalOpacity, rank, visible } = share;
  return (
    <Section title="In the pixel that was clicked">
      <Figure name="Share of the pixel" code="weight" value={percent(weight)} />
      <Figure name="Opacity there" code="alpha" value={percent(alpha)} />
      <Figure name="All splats together" code="totalOpacity" value={percent(totalOpacity)} />
      <Figure
        name="Rank from the nearest"
        code="rank"
        value={visible === null ? formatCount(rank) : `${formatCount(rank)} of ${formatCount(visible)}`}
      />
    </Section>
  );
}

function Values({ set }: { set: SplatSet }) {
  const { origin, positions, logScales, rotations, opacityLogits, harmonics } = set;
  const scales = Array.from(logScales, Math.exp);
  const logit = opacityLogits[0];
  return (
    <Section title="In the file">
      <Figure
        name="Position"
        code="x y z"
        value={figures(
          Array.from(positions, (value, axis) => value + origin[axis]),
          6,
        )}
        testId="inspect-position"
      />
      <Figure name="Scales" code="scale_0…2" value={figures(scales, 4)} testId="inspect-scales" />
      <Figure name="Rotation, w x y z" code="rot_0…3" value={figures(Array.from(rotations), 4)} />
      <Figure
        name="Opacity"
        code="opacity"
        value={`${percent(1 / (1 + Math.exp(-logit)))}, logit ${formatFigure(logit)}`}
      />
      <Figure name="Degree of harmonics" code="degree" value={String(harmonics.degree)} />
    </Section>
  );
}

function Seen({ seen }: { seen: TracedSplat | null }) {
  if (!seen) return <p>The camera does not see this splat now.</p>;
  const { depthView, majorPx, minorPx, colors } = seen;
  const size = [majorPx, minorPx].map((axis) => (2 * Math.hypot(...axis)).toFixed(1));
  return (
    <>
      <Section title="Seen from here">
        <Figure name="Depth" code="depthView" value={formatFigure(depthView)} testId="inspect-depth" />
        <Figure name="Size in the picture" code="px" value={size.join(' × ')} />
      </Section>
      <table className="inspect-colors" data-testid="inspect-colors">
        <caption>Colour by degree of harmonics, 8-bit</caption>
        <tbody>
          {colors.map((color, degree) => (
            <tr key={UP_TO[degree]}>
              <th scope="row">{UP_TO[degree]}</th>
              <td>
                <i style={{ background: cssColor(color) }} />
              </td>
              {color.map((channel, i) => (
                <td key={'rgb'[i]}>{Math.round(255 * channel)}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </>
  );
}

function Section({ title, children }: { title: string; children: ReactNode }) {
  return (
    <section className="inspect-figures">
      <h4>{title}</h4>
      <dl>{children}</dl>
    </section>
  );
}

function Figure({
  name,
  code,
  value,
  testId,
}: {
  name: string;
  code: string;
  value: string;
  testId?: string;
}) {
  return (
    <div>
      <dt>
        {name} <code>{code}</code>
      </dt>
      <dd data-testid={testId}>{value}</dd>
    </div>
  );
}

function figures(values: readonly number[], digits: number): string {
  return values.map((value) => formatFigure(value, digits)).join('  ');
}

function percent(part: number): string {
  return `${formatFigure(100 * part, 3)} %`;
}

function cssColor(color: Vec3): string {
  return `rgb(${color.map((channel) => Math.round(255 * Math.min(1, channel))).join(' ')})`;
}
