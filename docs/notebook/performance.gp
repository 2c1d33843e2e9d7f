# gnuplot docs/notebook/performance.gp, from the root of the repository: the plots of docs/reference/performance.md from the committed results.
set datafile separator ','
set terminal svg size 800,560 font 'DejaVu Sans,14' background '#ffffff'
set grid lc rgb '#dddddd'
results = 'benchmarks/results/paper_rule.csv'
row(name, density) = sprintf('< awk -F, ''$2=="%s" && $4==%s'' %s', name, density, results)
set logscale xy
set xlabel 'number of disks N'
set ylabel 'ns per disk and step'
set key top left
set yrange [20:1200]
set format x '10^{%T}'
set output 'docs/images/performance_n.svg'
set title 'The paper''s rule, one core, cost against N'
plot row('lists finest k', '0.7') using 3:5 with linespoints title 'linked lists, finest k, φ = 0.7', \
     row('lists finest k', '0.3') using 3:5 with linespoints title 'linked lists, finest k, φ = 0.3', \
     row('stepped', '0.7') using 3:5 with linespoints title 'stepped, φ = 0.7', \
     row('stepped', '0.3') using 3:5 with linespoints title 'stepped, φ = 0.3', \
     row('tiled 1 thread', '0.7') using 3:5 with linespoints title 'tiled, φ = 0.7', \
     row('tiled 1 thread', '0.3') using 3:5 with linespoints title 'tiled, φ = 0.3', \
     row('tiled 2 threads (wall)', '0.7') using 3:5 with linespoints title 'tiled, 2 threads, wall time, φ = 0.7'

# The paper's Figure 5: cost against the number of cells a side.
over_k(n) = sprintf('< awk -F, ''$1=="paper_rule_over_k" && $3==%s { sub("lists k=", "", $2); print $2 "," $5 }'' %s', n, results)
set output 'docs/images/performance_k.svg'
set title 'The paper''s rule on linked lists, one core, cost against k, φ = 0.7'
set xlabel 'cells a side k'
set key top right
set yrange [100:200000]
plot over_k('100') using 1:2 with linespoints title 'N = 100', \
     over_k('841') using 1:2 with linespoints title 'N = 841', \
     over_k('10000') using 1:2 with linespoints title 'N = 10^4', \
     over_k('100000') using 1:2 with linespoints title 'N = 10^5', \
     over_k('1000000') using 1:2 with linespoints title 'N = 10^6', \
     over_k('10000000') using 1:2 with linespoints title 'N = 10^7'
