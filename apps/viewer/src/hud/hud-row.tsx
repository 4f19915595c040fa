/** A line of the figures: a name, and a figure of the image or one of each side. */
export function HudRow({
  label,
  figure,
  rightFigure,
  unit,
  swatch,
  title,
  className,
  isOptional = false,
  testId,
}: {
  label: string;
  figure: string;
  /** The figure of the right side of a split image. */
  rightFigure?: string;
  unit?: string;
  /** Class of a small square in the colour of a bar. */
  swatch?: string;
  title?: string;
  className?: string;
  /** Whether the line is hidden while its figures are empty. */
  isOptional?: boolean;
  testId?: string;
}) {
  const row = isOptional ? [figure, rightFigure].join(' ').trim() : undefined;
  return (
    <div className={className} title={title} data-row={row}>
      <dt>
        {swatch && <i className={swatch} aria-hidden="true" />}
        {label}
      </dt>
      {[figure, rightFigure].map(
        (name, i) =>
          name && (
            <dd key={name}>
              <span data-figure={name} data-testid={i === 0 ? testId : undefined} />
              {unit && <small> {unit}</small>}
            </dd>
          ),
      )}
    </div>
  );
}
