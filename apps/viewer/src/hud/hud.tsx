import { memo, useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { bindHud } from './hud-binding.ts';

const STAGES = [
  ['preprocess', 'Pre-process'],
  ['sort', 'Sort'],
  ['rasterize', 'Rasterize'],
] as const;

/** The cost of the frame. React renders it once; from then on the figures are written into it directly. */
export const Hud = memo(function Hud({ store }: { store: ViewerStore }) {
  const isVisible = useStore(store, (state) => state.isHudVisible);
  const root = useRef<HTMLElement>(null);
  useEffect(() => {
    if (isVisible && root.current) return bindHud(root.current, store);
  }, [store, isVisible]);
  if (!isVisible) return null;
  return (
    <section ref={root} className="panel hud" aria-label="Frame figures" data-testid="hud">
      <p className="hud-pace">
        <span>
          <b data-figure="frameMs" /> ms
        </span>
        <span>
          <b data-figure="rate" /> <span data-figure="rateUnit" />
        </span>
      </p>
      <div className="hud-bar" aria-hidden="true">
        {STAGES.map(([name]) => (
          <i key={name} className={`stage-${name}`} data-share={name} />
        ))}
      </div>
      <dl>
        {STAGES.map(([name, label]) => (
          <div key={name}>
            <dt>
              <i className={`stage-${name}`} aria-hidden="true" />
              {label}
            </dt>
            <dd>
              <span data-figure={name} data-testid={`${name}-ms`} /> <small>ms</small>
            </dd>
          </div>
        ))}
        <div className="hud-total">
          <dt>Total</dt>
          <dd>
            <span data-figure="total" data-testid="total-ms" /> <small>ms</small>
          </dd>
        </div>
      </dl>
      <p className="hud-source" data-figure="source" data-testid="timing-source" />
      <dl>
        <div data-title="rasterizerReason">
          <dt>Rasteriser</dt>
          <dd>
            <span data-figure="rasterizer" data-testid="rasterizer" />{' '}
            <small data-figure="otherRasterizer" data-testid="other-rasterizer" />{' '}
            <span
              className="visually-hidden"
              data-figure="rasterizerReason"
              data-testid="rasterizer-reason"
            />
          </dd>
        </div>
        <div>
          <dt>Visible</dt>
          <dd data-figure="visible" data-testid="visible-splats" />
        </div>
        <div>
          <dt>Loaded</dt>
          <dd data-figure="loaded" data-testid="loaded-splats" />
        </div>
      </dl>
      <dl className="hud-device">
        <div>
          <dt>Image</dt>
          <dd data-figure="resolution" data-testid="resolution" />
        </div>
        <div>
          <dt>GPU</dt>
          <dd data-figure="adapter" data-testid="adapter" />
        </div>
      </dl>
    </section>
  );
});
