// A long drive as a table: eight times around a hall with pillars, 16 sensors, ranges in whole inches. The same bytes each time.
const INCH = 0.0254;
const HALL = [-22, -14, 22, 14];
const PILLARS = Array.from({ length: 24 }, (_, i) => [-17 + (i % 8) * 4.9, -7 + Math.floor(i / 8) * 7, 0.25]);

/** The distance from a point in a direction to the walls and pillars. */
function ray(x, y, angle) {
  const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
  let nearest = Infinity;
  const [left, bottom, right, top] = HALL;
  for (const [wall, from, way] of [[left, x, dx], [right, x, dx], [bottom, y, dy], [top, y, dy]]) {
    const distance = (wall - from) / way;
    if (distance > 0) nearest = Math.min(nearest, distance);
  }
  for (const [px, py, radius] of PILLARS) {
    const [ox, oy] = [px - x, py - y];
    const along = ox * dx + oy * dy;
    const off = Math.abs(ox * dy - oy * dx);
    if (along > 0 && off < radius) nearest = Math.min(nearest, along - Math.sqrt(radius * radius - off * off));
  }
  return nearest;
}

/** At least `count` readings, as CSV. */
export function longDrive(count) {
  const lines = ["t,sensor,range,x,y,yaw"];
  const sweeps = Math.ceil(count / 16);
  for (let i = 0; i < sweeps; i++) {
    const turn = (i / sweeps) * 2 * Math.PI * 8.3;
    const [x, y] = [19.2 * Math.cos(turn), 10.6 * Math.sin(turn) + 0.8 * Math.sin(5 * turn)];
    const yaw = Math.atan2(10.6 * Math.cos(turn) + 4 * Math.cos(5 * turn), -19.2 * Math.sin(turn));
    for (let sensor = 0; sensor < 16; sensor++) {
      const mount = (sensor * Math.PI) / 8;
      const [sx, sy] = [x + 9 * INCH * Math.cos(yaw + mount), y + 9 * INCH * Math.sin(yaw + mount)];
      let range = Infinity;
      for (let part = -4; part <= 4; part++) range = Math.min(range, ray(sx, sy, yaw + mount + (part * Math.PI) / 72));
      const inches = Math.round(range / INCH);
      const cell = inches < 255 ? (inches * INCH).toFixed(4) : "inf";
      lines.push(`${(i * 0.25).toFixed(2)},${sensor},${cell},${x.toFixed(4)},${y.toFixed(4)},${yaw.toFixed(5)}`);
    }
  }
  return lines.join("\n") + "\n";
}
